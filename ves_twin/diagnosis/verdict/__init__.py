"""What a diagnosis says, as it stands in verdict.json."""
