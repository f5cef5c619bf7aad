import type uPlot from 'uplot';

/** Something that can be zoomed and shown entirely again. */
export interface Zoomable {
  readonly is_zoomed: boolean;
  reset(): void;
}

/** The ordinate that a reader has chosen for a panel; null: that of what is in sight. */
export interface PanelView {
  y: [number, number] | null;
}

/** All plots over the same abscissa (by name), zoomed together: what happened at that moment in everything else? */
export class ZoomGroup implements Zoomable {
  private readonly plots = new Map<uPlot, PanelView>();
  private low = Infinity;
  private high = -Infinity;
  private zoomed = false;
  private shown: [number, number] | null = null;
  private readonly pointed = new Set<(at: number) => void>();
  private readonly lines = new Map<uPlot, HTMLElement>();
  /** The moment that is marked in all plots; null: none. */
  private moment: number | null = null;
  /** The plot on which the button went down last. */
  grasped: uPlot | null = null;

  constructor(
    readonly key: string,
    private readonly on_change: () => void,
  ) {}

  get is_zoomed(): boolean {
    return this.zoomed || [...this.plots.values()].some((view) => view.y !== null);
  }

  /** The range that shows everything. */
  extend(low: number, high: number): void {
    this.low = Math.min(this.low, low);
    this.high = Math.max(this.high, high);
  }

  full(): [number, number] {
    return this.low < this.high ? [this.low, this.high] : [this.low - 0.5, this.low + 0.5];
  }

  add(plot: uPlot, view: PanelView): void {
    this.plots.set(plot, view);
    plot.over.addEventListener('mousedown', () => (this.grasped = plot), true);
    plot.over.addEventListener('mousemove', (event) => {
      const at = plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, 'x');
      for (const follow of this.pointed) follow(at);
    });
    this.place(plot);
  }

  /** Calls `follow` with the moment at which the pointer is in one of the plots. */
  on_point(follow: (at: number) => void): void {
    this.pointed.add(follow);
  }

  /** Marks a moment by a line across all plots. */
  mark(at: number): void {
    this.moment = at;
    for (const plot of this.plots.keys()) this.place(plot);
  }

  /** Puts the line where the moment is now. */
  place(plot: uPlot): void {
    if (this.moment === null) return;
    let line = this.lines.get(plot);
    if (!line) {
      line = document.createElement('div');
      line.className = 'moment';
      plot.over.append(line);
      this.lines.set(plot, line);
    }
    const left = plot.valToPos(this.moment, 'x');
    line.hidden = !(left >= 0 && left <= plot.over.clientWidth);
    line.style.transform = `translateX(${left}px)`;
  }

  zoom(from: number, to: number): void {
    const [low, high] = this.full();
    const min = Math.max(low, Math.min(from, to));
    const max = Math.min(high, Math.max(from, to));
    if (!(max - min > (high - low) * 1e-6)) return;
    this.zoomed = min > low || max < high;
    this.apply(min, max);
  }

  /** Takes over an ordinate that a plot's view has been given. */
  refresh(plot: uPlot): void {
    const [min, max] = this.window;
    plot.setScale('x', { min, max });
    this.on_change();
  }

  reset(): void {
    this.zoomed = false;
    for (const view of this.plots.values()) view.y = null;
    this.apply(...this.full());
  }

  /** The range in sight. uPlot's own x scale is still the old one while it asks for the range of y. */
  get window(): [number, number] {
    return this.shown ?? this.full();
  }

  private apply(min: number, max: number): void {
    this.shown = [min, max];
    for (const plot of this.plots.keys()) plot.setScale('x', { min, max });
    this.on_change();
  }
}

const groups = new Map<string, ZoomGroup>();
const zoomables = new Set<Zoomable>();
const watchers = new Set<() => void>();

/** Tells that something was zoomed or shown entirely. */
export function zoom_changed(): void {
  for (const watcher of watchers) watcher();
}

export function zoom_group(key: string): ZoomGroup {
  const found = groups.get(key) ?? new ZoomGroup(key, zoom_changed);
  groups.set(key, found);
  zoomables.add(found);
  return found;
}

export function add_zoomable(each: Zoomable): void {
  zoomables.add(each);
}

export function any_zoomed(): boolean {
  return [...zoomables].some((each) => each.is_zoomed);
}

export function reset_zoom(): void {
  for (const each of zoomables) if (each.is_zoomed) each.reset();
}

export function on_zoom_change(watcher: () => void): void {
  watchers.add(watcher);
}

/** uPlot knows the mouse only: a finger drawn sideways selects, two taps reset; up and down still scrolls the page. */
export function follow_touch(plot: uPlot): void {
  const { over } = plot;
  over.style.touchAction = 'pan-y';
  let last_tap = 0;
  const send = (type: string, event: PointerEvent) =>
    (type === 'mouseup' ? document : over).dispatchEvent(
      // uPlot takes a move without movement for a phantom.
      new MouseEvent(type, { clientX: event.clientX, clientY: event.clientY, movementX: 1, button: 0, bubbles: true }),
    );
  over.addEventListener('pointerdown', (event) => {
    if (event.pointerType !== 'touch' || !event.isPrimary) return;
    over.setPointerCapture(event.pointerId);
    send('mouseenter', event);
    send('mousemove', event);
    send('mousedown', event);
  });
  over.addEventListener('pointermove', (event) => {
    if (event.pointerType === 'touch' && event.isPrimary) send('mousemove', event);
  });
  over.addEventListener('pointerup', (event) => {
    if (event.pointerType !== 'touch' || !event.isPrimary) return;
    send('mouseup', event);
    if (event.timeStamp - last_tap < 350) send('dblclick', event);
    last_tap = event.timeStamp;
  });
  over.addEventListener('pointercancel', (event) => {
    if (event.pointerType === 'touch') send('mouseup', event);
  });
}
