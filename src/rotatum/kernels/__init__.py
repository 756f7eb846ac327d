"""The mathematics, one step at a time, in the subset that compiles and exports to C."""
