"""The blocks of a hybrid test that a campaign lets us see, each replayed by itself."""
