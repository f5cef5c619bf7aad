import type { Line, Role } from '../document';
import { h } from '../dom';
import { palette } from '../theme';
import type { LineLook } from './frame';

/** Which series of a figure are switched off, by name and role: one switch for all of its panels. */
export class SeriesSwitch {
  private readonly off = new Set<string>();
  private readonly watchers = new Set<() => void>();

  shows(name: string, role: Role): boolean {
    return !this.off.has(`${role}/${name}`);
  }

  toggle(name: string, role: Role): void {
    const key = `${role}/${name}`;
    if (!this.off.delete(key)) this.off.add(key);
    for (const watcher of this.watchers) watcher();
  }

  on_change(watcher: () => void): void {
    this.watchers.add(watcher);
  }
}

export function swatch(look: LineLook, style: Line['style'], has_band: boolean): HTMLElement {
  const index = Math.max(-1, palette().lines.indexOf(look.colour(palette())));
  const name = index >= 0 ? `--line-${index + 1}` : look.dash.length > 0 ? '--reference' : '--measured';
  const kind = style === 'markers' ? 'dots' : look.dash.length === 0 ? 'solid' : index >= 0 ? 'dotted' : 'dashed';
  return h('span', { class: `swatch ${kind}${has_band ? ' banded' : ''}`, style: `--colour: var(${name})`, 'aria-hidden': 'true' });
}

export interface LegendEntry {
  element: HTMLLIElement;
  /** Says whether the series leaves the scale. */
  mark(off_scale: boolean): void;
}

/** An entry of a legend that switches its series, by a click or by the keyboard. */
export function legend_entry(series: { name: string; role: Role }, look: LineLook, style: Line['style'], has_band: boolean, shown: SeriesSwitch, ...rest: HTMLElement[]): LegendEntry {
  const button = h(
    'button',
    { type: 'button', class: 'switch', 'aria-pressed': 'true', title: 'Show or hide', click: () => shown.toggle(series.name, series.role) },
    swatch(look, style, has_band),
    h('span', { class: 'name' }, series.name),
  );
  shown.on_change(() => button.setAttribute('aria-pressed', String(shown.shows(series.name, series.role))));
  const note = h('span', { class: 'off-scale', hidden: true }, 'off scale');
  return {
    element: h('li', {}, button, note, ...rest),
    mark: (off_scale) => {
      if (note.hidden === off_scale) note.hidden = !off_scale;
    },
  };
}

export interface RangeButton {
  element: HTMLButtonElement;
  /** Whether the whole range of every series is to be seen. */
  pressed(): boolean;
  offer(needed: boolean): void;
}

/** The control that shows the whole range where a series leaves the scale; unseen while none does. */
export function range_button(on_press: () => void): RangeButton {
  let on = false;
  const element = h('button', {
    type: 'button',
    class: 'quiet full-range',
    'aria-pressed': 'false',
    hidden: true,
    click: () => {
      on = !on;
      element.setAttribute('aria-pressed', String(on));
      on_press();
    },
  }, 'Full range');
  return {
    element,
    pressed: () => on,
    offer: (needed) => {
      if (element.hidden === (needed || on)) element.hidden = !(needed || on);
    },
  };
}
