"""The methods, one file each: `none`, `paper`, `cells`, `certified`, `auto` and `free`, and what can be added to them,
`cache` and `rest`.  `interface` says what a method is; `tracer.method` what methods are called."""
