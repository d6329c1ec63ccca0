"""The reference solvers: they march what a scheme file says, to cross-validate what the normal modes predict.

They share the reader of scheme files with the analyser and nothing else.
"""
