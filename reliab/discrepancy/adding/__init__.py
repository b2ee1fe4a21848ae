"""What a diagnosis adds to the model, with its uncertainty."""
