import { h } from '../dom';

/** Pixels of a saved picture per CSS pixel. */
const kPixelRatio = 2;

function file_name(title: string): string {
  const slug = (text: string) => text.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '');
  return slug(title).slice(0, 80) || 'figure';
}

function download(blob: Blob, name: string): void {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  // Later: some browsers read it only after the click.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

function text_of(picture: SVGSVGElement): string {
  return new XMLSerializer().serializeToString(picture);
}

async function as_png(picture: SVGSVGElement): Promise<Blob> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text_of(picture))}`;
  await image.decode();
  const canvas = h('canvas', { width: kPixelRatio * image.width, height: kPixelRatio * image.height });
  canvas.getContext('2d')?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done, fail) => canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error('no picture'))), 'image/png'));
}

/** Buttons that save a figure as it stands: as a drawing (SVG) or as an image (PNG). */
export function save_buttons(title: string, picture: () => SVGSVGElement): HTMLElement {
  const button = (kind: 'SVG' | 'PNG', make: () => Promise<Blob>) =>
    h(
      'button',
      { type: 'button', class: 'quiet', title: `Save as ${kind}`, 'aria-label': `Save ${title || 'the figure'} as ${kind}`, click: () => void make().then((blob) => download(blob, `${file_name(`${document.title} ${title}`)}.${kind.toLowerCase()}`)) },
      kind,
    );
  return h(
    'div',
    { class: 'tools' },
    button('SVG', async () => new Blob([text_of(picture())], { type: 'image/svg+xml' })),
    button('PNG', () => as_png(picture())),
  );
}
