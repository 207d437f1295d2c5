"""Laws: from recordings that no cause explains to a function at a place, with a band."""
