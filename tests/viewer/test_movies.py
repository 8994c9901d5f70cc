"""Movies as a browser plays them: a decoder that is not the encoder's."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from tests.helpers.browser import opened

#: Seeks a film to some seconds, and returns its size, its length, and the brightest and the mean level at each.
LOOK = """async (places) => {
  const video = document.querySelector("video");
  const heard = (name) => new Promise((done) => video.addEventListener(name, done, { once: true }));
  if (video.readyState < 2) await heard("loadeddata");
  const canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight).getContext("2d");
  const levels = [];
  for (const place of places) {
    const there = heard("seeked");
    const painted = new Promise((done) => video.requestVideoFrameCallback(done));
    const late = new Promise((done) => setTimeout(done, 2000)); // where it is there already
    video.currentTime = place;
    await there;
    await Promise.race([painted, late]);
    canvas.drawImage(video, 0, 0);
    const { data } = canvas.getImageData(0, 0, video.videoWidth, video.videoHeight);
    const colours = data.filter((_, i) => i % 4 < 3);
    levels.push([colours.reduce((a, b) => Math.max(a, b)), colours.reduce((a, b) => a + b) / colours.length]);
  }
  return { size: [video.videoWidth, video.videoHeight], seconds: video.duration, levels };
}"""


def test_a_browser_plays_what_is_to_be_sent_from_rest_to_rest(browser: Any, tmp_path: Path) -> None:
    grid = lc.Grid((6, 8, 8))
    extinction = 3 * (np.random.default_rng(3).random((3, *grid.shape)) < 0.1).astype(np.float32)
    cube = lc.Cube(extinction, grid, lc.turntable(grid, [20.0, 100.0], elevation_deg=20.0, picture_shape=(4, 6)))
    film = lc.film(cube, format="square", fps=4)
    path = lc.save(film, tmp_path / "a.mp4", fps=4, shared=True)
    source = base64.b64encode(path.read_bytes()).decode()
    (tmp_path / "a.html").write_text(f"<video muted src='data:video/mp4;base64,{source}'></video>")
    tab, heard = opened(browser, tmp_path / "a.html")
    if not tab.evaluate("document.createElement('video').canPlayType('video/mp4; codecs=\"avc1.640028\"')"):
        pytest.skip("this browser knows no H.264")
    seconds = len(film) / 4
    found = tab.evaluate(LOOK, [0.0, 2.1, seconds - 0.1])  # half a rest is two frames, a fade six
    assert found["size"] == [1080, 1080]
    assert found["seconds"] == pytest.approx(seconds, abs=0.05)
    (first, mean), (dark, _), (last, _) = found["levels"]
    assert min(first, last) > 100
    assert dark <= 3
    assert mean > 5
    assert not heard
    tab.context.close()
