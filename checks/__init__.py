"""House rules as programs: what `make check` runs beside the linters."""
