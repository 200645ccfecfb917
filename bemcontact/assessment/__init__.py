"""Judging a solution: everything is recomputed from the condensed problem and the returned p and u_n."""
