"""Makes the sounds of messages to the driver: tones, and every standard text in every language, spoken by eSpeak NG.

    python tools/make_sounds.py [OUT]

OUT is `scenario_compiler/live/pages/sounds` by default. A folder for each language and one for the tones are written to
it, with Opus in Ogg at 48 kHz, and `sounds.json`, which contains the text, the duration and the SHA-256 of each file
and the licence. The program `espeak-ng` (Debian's package of that name) and PyAV (the extra `video`) are needed. The
same versions of both write the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import av
import numpy as np
import numpy.typing as npt

from scenario_compiler.live.sounds import SOUNDS
from scenario_compiler.runtime.messages import TEXTS

Samples = npt.NDArray[np.float32]

RATE = 48_000
"""Samples per second of every file."""

SPOKEN_AT = 22_050
"""Samples per second that eSpeak NG writes."""

VOICES = {"en": "en-gb", "de": "de", "fi": "fi", "sv": "sv"}
"""eSpeak NG's own voice for each language. MBROLA's voices are not used, because their licences restrict use."""

WORDS_A_MINUTE = 160

TONES = {"warning": [(660.0, 0.0, 0.18)], "request": [(880.0, 0.0, 0.14), (880.0, 0.22, 0.14), (880.0, 0.44, 0.14)]}
"""The sine waves of each tone by its name: (frequency in Hz, start in s, duration in s)."""

FADE = 0.01
"""Duration over which a sine wave fades in and out, s."""

LOUDNESS = 0.12
"""Root mean square of the louder half of each text; full scale is 1."""

QUIET = 0.005
"""Amplitude up to which the ends of a text count as silence; full scale is 1."""

LICENCE = (
    "MIT, as the project. Tones are computed. Texts are the project's own, spoken by eSpeak NG, which is free software "
    "under the GNU General Public License, version 3 or later. That licence covers what a program puts out only if the "
    "output, given its content, constitutes a covered work (its section 2); speech of other texts is none."
)


def spoken(text: str, voice: str) -> Samples:
    """Return a spoken text as samples in -1 to 1 at `RATE`, without silence at its ends; all texts are equally loud."""
    sentence = f"{text[:1].upper()}{text[1:]}."
    command = ["espeak-ng", "-v", voice, "-s", str(WORDS_A_MINUTE), "--stdout", sentence]
    wave = subprocess.run(command, capture_output=True, check=True).stdout
    samples = np.frombuffer(wave[44:], dtype="<i2").astype(np.float32) / 32768.0
    loud = np.flatnonzero(np.abs(samples) > QUIET)
    samples = samples[loud[0] : loud[-1] + 1]
    times = np.arange(int(len(samples) * RATE / SPOKEN_AT)) * (SPOKEN_AT / RATE)
    samples = np.interp(times, np.arange(len(samples)), samples).astype(np.float32)
    parts = samples[: len(samples) // 960 * 960].reshape(-1, 960)
    power = np.sort((parts**2).mean(axis=1))
    louder = float(np.sqrt(power[len(power) // 2 :].mean()))
    return np.asarray(np.clip(samples * (LOUDNESS / louder), -0.95, 0.95), np.float32)


def tone(waves: list[tuple[float, float, float]]) -> Samples:
    """Return a tone of sine waves (frequency in Hz, start in s, duration in s) as samples in -1 to 1 at `RATE`."""
    samples = np.zeros(round(RATE * max(begin + duration for _, begin, duration in waves)), dtype=np.float32)
    for frequency, begin, duration in waves:
        t = np.arange(round(RATE * duration)) / RATE
        edge = np.minimum(1.0, np.minimum(t, duration - t) / FADE)
        at = round(RATE * begin)
        samples[at : at + len(t)] = 0.25 * edge * np.sin(2.0 * np.pi * frequency * t)
    return samples


def write_opus(samples: Samples, path: Path) -> None:
    """Write samples to a file as Opus in Ogg; its folder is created if it does not exist."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(str(path), "w", format="ogg", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream("libopus", rate=RATE, layout="mono", options={"application": "voip"})
        stream.bit_rate = 24_000
        stream.codec_context.options = {"flags": "+bitexact"}
        frame = av.AudioFrame.from_ndarray(samples.reshape(1, -1), format="flt", layout="mono")
        frame.sample_rate = RATE
        for packet in (*stream.encode(frame), *stream.encode(None)):
            container.mux(packet)


def main() -> None:
    """Write all sounds and sounds.json."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else SOUNDS
    version = subprocess.run(["espeak-ng", "--version"], capture_output=True, text=True, check=True).stdout
    files: dict[str, Any] = {}
    made: dict[str, tuple[str, Samples]] = {f"tones/{name}": ("", tone(waves)) for name, waves in TONES.items()}
    for language, texts in TEXTS.items():
        made |= {f"{language}/{name}": (text, spoken(text, VOICES[language])) for name, text in texts.named.items()}
    for name, (text, samples) in made.items():
        path = out / f"{name}.opus"
        write_opus(samples, path)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        files[f"{name}.opus"] = {"text": text, "seconds": round(len(samples) / RATE, 2), "sha256": digest}
    by = f"tools/make_sounds.py, {version.split('  ')[0].strip()}, voices {', '.join(VOICES.values())}"
    listed = {"made_by": by, "licence": LICENCE, "files": files}
    (out / "sounds.json").write_text(json.dumps(listed, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{len(files)} files, {sum((out / name).stat().st_size for name in files)} bytes")


if __name__ == "__main__":
    main()
