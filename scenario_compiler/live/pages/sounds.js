// Tones, speech and vibration of messages. They are started and never waited for; each reports its channel.

const APART = 0.12; // seconds between two texts of a message
const SPOKEN_WITHIN = 1500; // milliseconds after which a browser that has not begun to speak is taken to be mute

let context = null;
let playing = [];
let toneUntil = 0; // by the clock of the sounds, seconds
let beginning; // the browser's speech that waits for the end of a tone
const files = new Map();

/** Fetch and decode files, so that they are ready when they are needed. */
export function load(names) {
  const decoder = new OfflineAudioContext(1, 1, 48000);
  return Promise.all(
    names.map(async (name) => {
      const answer = await fetch(`/sounds/${name}`);
      if (answer.ok) files.set(name, await decoder.decodeAudioData(await answer.arrayBuffer()).catch(() => null));
    }),
  );
}

/** Allow sounds; browsers require the press of a key or a button first. */
export function allow() {
  context ??= new AudioContext();
  context.resume();
}

/** Play files one after the other from a time on; null if one of them is missing or sounds are not allowed. */
function play(names, from = 0) {
  const buffers = names.map((name) => files.get(name));
  if (!names.length || context?.state !== "running" || !buffers.every(Boolean)) return null;
  let at = Math.max(context.currentTime, from);
  return buffers.map((buffer) => {
    const source = context.createBufferSource();
    source.buffer = buffer;
    source.connect(context.destination);
    source.start(at);
    at += buffer.duration + APART;
    return source;
  });
}

/** Sound a tone. */
export function tone(names, given) {
  const sounded = play(names);
  if (sounded) toneUntil = context.currentTime + sounded[0].buffer.duration + APART;
  given(sounded ? "file" : "none");
}

/**
 * Speak a text instead of the present one: from files, otherwise by the browser; `given` may be called later. Speech begins
 * when a tone has ended, which would cover its first word.
 */
export function speak(text, language, names, given) {
  hush();
  playing = play(names, toneUntil) ?? [];
  if (playing.length) return given("file");
  const synthesis = globalThis.speechSynthesis;
  if (!synthesis) return given("text");
  let open = true;
  const settle = (by) => {
    clearTimeout(waiting);
    if (open) given(by);
    open = false;
  };
  const wait = 1000 * Math.max(0, toneUntil - (context?.currentTime ?? 0));
  const waiting = setTimeout(() => settle("text"), wait + SPOKEN_WITHIN);
  const words = new SpeechSynthesisUtterance(text);
  words.lang = language;
  words.addEventListener("start", () => settle("browser"));
  words.addEventListener("error", () => settle("text"));
  beginning = setTimeout(() => synthesis.speak(words), wait);
}

/** Stop speaking. */
export function hush() {
  clearTimeout(beginning);
  playing.forEach((source) => source.stop());
  playing = [];
  globalThis.speechSynthesis?.cancel();
}

/** Vibrate a gamepad that supports it, otherwise a phone. */
export function vibrate(urgent, given) {
  const time = urgent ? 600 : 250;
  const pads = [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad?.vibrationActuator?.playEffect);
  for (const pad of pads) {
    pad.vibrationActuator.playEffect("dual-rumble", { duration: time, strongMagnitude: 0.8, weakMagnitude: 0.5 });
  }
  if (pads.length) given("gamepad");
  else given(matchMedia("(pointer: coarse)").matches && navigator.vibrate?.(time) ? "phone" : "none");
}
