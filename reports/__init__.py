"""Figures, tables and pages drawn from what the analysis and the solvers give."""
