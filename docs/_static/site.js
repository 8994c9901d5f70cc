// Pages that are opened from a disk may not read each other: there results of a search stand without their lines.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
