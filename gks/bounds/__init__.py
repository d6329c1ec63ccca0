"""The answers over parameters: stable sets in lam, curves, theorems."""
