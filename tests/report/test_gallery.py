"""The page that shows several cubes."""

import re

import numpy as np

from lightcube.report.gallery import Card, gallery

SEEN = np.full((3, 5, 3), 90, np.uint8)


def test_each_card_leads_to_its_page_and_markup_is_text() -> None:
    cards = [Card(f"cube <{number}>", "said & shown", SEEN, f"{number}.html") for number in range(3)]
    page = gallery("Three <cubes>", "lead", cards, ["make --it", "view <it>"])
    assert [page.count(f'href="{number}.html"') for number in range(3)] == [2, 2, 2]
    assert "cube &lt;1&gt;" in page
    assert "said &amp; shown" in page
    assert "view &lt;it&gt;" in page
    assert page.count("<img") == 3
    assert "default-src 'none'" in page.replace("&#x27;", "'")
    assert not re.search("<cubes>|<script|https?://", page)
