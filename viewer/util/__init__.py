"""What every part of the viewer uses: whole files, messages in one line, numbers, failures, where resources are."""
