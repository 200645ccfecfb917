"""Studies of parameters: grids of values, solved by several processes or on a cluster, one row for each member."""
