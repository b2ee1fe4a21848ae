"""What a diagnosis says, as objects and as the JSON that `reliab diagnose` writes."""
