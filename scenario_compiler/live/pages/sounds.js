// Tones and speech of messages. They are started and never waited for.

let context = null;

/** Allow sounds; browsers want a press of a key or a button first. */
export function allow() {
  context ??= new AudioContext();
  context.resume();
}

const TONES = { warning: [[660, 0, 0.18]], urgent: [[880, 0, 0.14], [880, 0.22, 0.14], [880, 0.44, 0.14]] };

/** Sound the tone of a warning, or of a request. */
export function tone(urgent) {
  if (!context || context.state !== "running") return;
  for (const [pitch, after, time] of TONES[urgent ? "urgent" : "warning"]) {
    const [source, volume] = [context.createOscillator(), context.createGain()];
    source.frequency.value = pitch;
    const begin = context.currentTime + after;
    volume.gain.setValueAtTime(0, begin);
    volume.gain.linearRampToValueAtTime(0.25, begin + 0.01);
    volume.gain.setValueAtTime(0.25, begin + time - 0.02);
    volume.gain.linearRampToValueAtTime(0, begin + time);
    source.connect(volume).connect(context.destination);
    source.start(begin);
    source.stop(begin + time);
  }
}

/** Let the browser speak a text, in place of what it is still speaking. */
export function speak(text, language = "en") {
  if (!globalThis.speechSynthesis) return;
  speechSynthesis.cancel();
  const words = new SpeechSynthesisUtterance(text);
  words.lang = language;
  speechSynthesis.speak(words);
}

/** Shake a gamepad that can, and a phone. */
export function vibrate(urgent) {
  const time = urgent ? 600 : 250;
  for (const pad of navigator.getGamepads?.() ?? []) {
    pad?.vibrationActuator?.playEffect?.("dual-rumble", { duration: time, strongMagnitude: 0.8, weakMagnitude: 0.5 });
  }
  navigator.vibrate?.(time);
}
