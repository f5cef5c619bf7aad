export type Theme = 'light' | 'dark';

const kKey = 'veridyn-theme';
const listeners = new Set<() => void>();
const dark_preferred = matchMedia('(prefers-color-scheme: dark)');
let chosen: Theme | null = null;
let printing = false;

try {
  const stored = localStorage.getItem(kKey);
  if (stored === 'light' || stored === 'dark') chosen = stored;
} catch {
  // Pages from a file may have no storage; the system's preference holds then.
}

/** The theme in force; paper is always light. */
export function theme(): Theme {
  if (printing) return 'light';
  return chosen ?? (dark_preferred.matches ? 'dark' : 'light');
}

function apply(): void {
  document.documentElement.dataset.theme = theme();
  for (const listener of listeners) listener();
}

export function toggle_theme(): void {
  chosen = theme() === 'dark' ? 'light' : 'dark';
  try {
    localStorage.setItem(kKey, chosen);
  } catch {
    // Not remembered, that is all.
  }
  apply();
}

export function set_printing(on: boolean): void {
  if (printing === on) return;
  printing = on;
  apply();
}

export function is_printing(): boolean {
  return printing;
}

/** Calls `listener` whenever colours have changed. */
export function on_theme_change(listener: () => void): void {
  listeners.add(listener);
}

dark_preferred.addEventListener('change', apply);
document.documentElement.dataset.theme = theme();

/** Colours for canvases, read from the style sheet so that there is one place for them. */
export interface Palette {
  ink: string;
  soft_ink: string;
  grid: string;
  surface: string;
  measured: string;
  reference: string;
  lines: string[];
  spans: Record<'primary' | 'secondary' | 'muted' | 'bad', string>;
}

export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  return {
    ink: colour('--ink'),
    soft_ink: colour('--ink-soft'),
    grid: colour('--grid'),
    surface: colour('--surface'),
    measured: colour('--measured'),
    reference: colour('--reference'),
    lines: [1, 2, 3, 4, 5, 6].map((k) => colour(`--line-${k}`)),
    spans: {
      primary: colour('--span-primary'),
      secondary: colour('--span-secondary'),
      muted: colour('--span-muted'),
      bad: colour('--span-bad'),
    },
  };
}
