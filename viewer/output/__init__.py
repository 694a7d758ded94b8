"""What comes out: pictures, figures, legends, tables and files, all drawn without a GPU."""
