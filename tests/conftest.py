"""Settings of the whole suite."""

from hypothesis import settings

# No deadline: the machine's load is not a property of the code. `--hypothesis-profile=long` searches 20 times as far.
settings.register_profile("house", deadline=None, print_blob=True)
settings.register_profile("long", settings.get_profile("house"), max_examples=2000)
# `brief` is for a second environment, where only what the first can't see matters.
settings.register_profile("brief", settings.get_profile("house"), max_examples=5)
settings.load_profile("house")
