// Numbers as people read them. What is missing or not finite is a dash, never a zero.

export const MINUS = "\u2212";

export function number(value, digits = 2) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = Math.abs(value).toFixed(digits);
  return value < 0 && Number(text) !== 0 ? MINUS + text : text;
}

export function signed(value, digits = 2) {
  const text = number(value, digits);
  return value > 0 && Number(text) !== 0 ? "+" + text : text;
}

export const degrees = (radians) => (Number.isFinite(radians) ? (radians * 180) / Math.PI : null);

export const milli = (value) => (Number.isFinite(value) ? value * 1e3 : null);

export function duration(seconds) {
  return seconds < 0.9995 ? `${(seconds * 1e3).toFixed(0)} ms` : seconds < 100 ? `${seconds.toFixed(1)} s` : `${Math.round(seconds)} s`;
}

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// Fits a canvas's pixels to the screen's, and returns its context and size in CSS pixels.
export function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const wanted = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wanted[0]) canvas.width = wanted[0];
  if (canvas.height !== wanted[1]) canvas.height = wanted[1];
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}
