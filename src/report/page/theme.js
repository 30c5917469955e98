// Light and dark: the colours of the style sheet, for what is drawn on canvas.

const NAMES = ["text", "muted", "faint", "grid", "paper", "panel", "steel", "steel-edge", "ghost", "now"];
const SERIES = 8;
const colours = { series: [] };
const watchers = [];

/** The colours in force, by the names they have in the style sheet. */
export function theme() {
  return colours;
}

/** The colour of a series by its number. */
export function seriesColour(number) {
  return colours.series[number % SERIES];
}

/** Calls back whenever the colours change. */
export function onTheme(watcher) {
  watchers.push(watcher);
}

/** Reads the colours in force and tells everybody. */
export function refreshTheme() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) colours[name] = style.getPropertyValue(`--${name}`).trim();
  colours.series = Array.from({ length: SERIES }, (_, k) => style.getPropertyValue(`--series-${k}`).trim());
  for (const watcher of watchers) watcher();
}

/** Follows the system until the button is pressed. */
export function setUpTheme(button) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  const show = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", isDark() ? "Switch to light colours" : "Switch to dark colours");
    refreshTheme();
  };
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    show();
  });
  dark.addEventListener("change", show);
  show();
}

/** Paper is light, whatever the screen is: to be called before and after printing. */
export function lightForPrint(printing) {
  document.documentElement.classList.toggle("printing", printing);
  refreshTheme();
}
