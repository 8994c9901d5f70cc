"""What inks really do: a page to print, found again in a photograph, and fitted."""
