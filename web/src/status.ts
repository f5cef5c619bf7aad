import { h } from './dom';

type Tone = 'good' | 'caution' | 'bad' | 'muted' | 'info';

const kStatus: Record<string, [label: string, tone: Tone, mark: string]> = {
  identified: ['identified', 'good', '✓'],
  insignificant: ['insignificant', 'muted', '○'],
  weak: ['weak', 'caution', '~'],
  effective: ['effective', 'caution', '!'],
  implausible: ['implausible', 'bad', '?'],
  at_bound: ['at its bound', 'bad', '|'],
  not_excited: ['not excited', 'caution', '–'],
  rejected: ['rejected', 'bad', '×'],
  fixed: ['fixed', 'info', '='],
  good: ['good', 'good', '✓'],
  caution: ['caution', 'caution', '!'],
  bad: ['bad', 'bad', '×'],
};

export function status_label(status: string): string {
  return kStatus[status]?.[0] ?? status.replaceAll('_', ' ');
}

export function status_tone(status: string): Tone {
  return kStatus[status]?.[1] ?? 'muted';
}

/** A coloured badge; its mark and word say the same as its colour. */
export function badge(status: string, text?: string): HTMLElement {
  const mark = kStatus[status]?.[2] ?? '•';
  return h('span', { class: `badge ${status_tone(status)}` }, h('span', { class: 'mark', 'aria-hidden': 'true' }, mark), text ?? status_label(status));
}
