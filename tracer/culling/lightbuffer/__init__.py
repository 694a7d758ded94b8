"""The light buffer: what each light sees in each direction, proven with the roundings of float32."""
