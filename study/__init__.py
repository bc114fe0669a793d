"""Studies: users of the package that compare, measure and judge it; README.md lists them."""
