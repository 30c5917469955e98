// Numbers and units as people read them.

const PREFIXES = [["p", 1e-12], ["n", 1e-9], ["µ", 1e-6], ["m", 1e-3], ["", 1], ["k", 1e3], ["M", 1e6], ["G", 1e9]];

/** A number with so many significant digits and a true minus sign; a dash where there is none. */
export function significant(value, digits) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent < -4 || exponent > 6) {
    const [lead, power] = value.toExponential(digits - 1).split("e");
    return `${trueMinus(lead)} × 10${superscript(Number(power))}`;
  }
  return trueMinus(value.toFixed(Math.max(0, Math.min(15, digits - 1 - exponent))));
}

/** A number with so many decimals and a true minus sign. */
export function fixed(value, decimals) {
  return Number.isFinite(value) ? trueMinus(value.toFixed(decimals)) : "–";
}

/** A whole number as an exponent. */
function superscript(number) {
  return String(number).replace(/[-\d]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
}

/** A value in a prefixed unit, `6.1 kN` or `−1.9 × 10³ rad/s²`. */
export function inUnit(value, { unit, size }, digits) {
  return `${significant(value / size, digits)} ${unit.startsWith("10") ? "× " : ""}${unit}`;
}

export function trueMinus(text) {
  return text.replace(/-/g, "−");
}

/** A time (s) in milliseconds, with decimals that tell its samples apart. */
export function milliseconds(time, decimals = 4) {
  return fixed(time * 1e3, decimals);
}

/** The prefixed unit in which the largest value reads well, and what one of it is in the unit. */
export function prefixed(unit, largest) {
  if (!(largest > 0)) return { unit, size: 1 };
  if (unit.startsWith("rad")) {
    return largest >= 1e4 ? { unit: `10³ ${unit}`, size: 1e3 } : { unit, size: 1 };
  }
  let best = PREFIXES[0];
  for (const prefix of PREFIXES) if (largest >= 0.9999 * prefix[1]) best = prefix;
  return { unit: best[0] + unit, size: best[1] };
}

/** The largest of 1, 2, 5 times a power of ten that is no larger. */
export function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

/** A slow motion, as `1 / 500`. */
export function fraction(speed) {
  return speed >= 1 ? `${speed} ×` : `1 / ${Math.round(1 / speed)}`;
}
