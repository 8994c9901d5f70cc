// Takes a picture by the webcam.

import { element } from "/viewer/tools/elements.js";
import { openDialog } from "./dialogs.js";

/** @returns {Promise<File|null>} */
export async function openWebcam(studio) {
  const stream = await (navigator.mediaDevices?.getUserMedia({ video: true }) ?? Promise.reject()).catch(() => null);
  if (stream === null) {
    studio.say("No webcam can be had: plug one in, or let your browser use it.", "bad");
    return null;
  }
  const seen = element("video", { class: "film", autoplay: true, muted: true, playsinline: true });
  seen.srcObject = stream;
  const taken = await openDialog(studio.root, "Take a picture", [seen], "Take it", () => {
    const canvas = element("canvas", { width: seen.videoWidth, height: seen.videoHeight });
    canvas.getContext("2d").drawImage(seen, 0, 0);
    return canvas;
  });
  for (const track of stream.getTracks()) track.stop();
  if (taken === null || taken.width === 0) return null;
  const blob = await new Promise((resolve) => taken.toBlob(resolve, "image/png"));
  return new File([blob], "webcam.png", { type: "image/png" });
}
