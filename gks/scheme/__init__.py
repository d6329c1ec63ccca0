"""What the user wrote: scheme files read into exact, immutable data, without floats and without analysis."""
