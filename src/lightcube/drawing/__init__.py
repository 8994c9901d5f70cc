"""Pictures for people: sheets, plots, plans, charts, the room in perspective."""
