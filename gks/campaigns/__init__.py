"""Long runs over many points or schemes: in chunks, on any executor, checkpointed, and the same whatever ran them."""
