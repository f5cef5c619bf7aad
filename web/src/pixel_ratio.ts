// Canvases are drawn with at least two pixels per CSS pixel, so that figures stay sharp on paper. uPlot reads the ratio
// while its module loads: import this file before it.
const screen_ratio = Object.getOwnPropertyDescriptor(window, 'devicePixelRatio')?.get;
if (screen_ratio) {
  Object.defineProperty(window, 'devicePixelRatio', {
    configurable: true,
    get: () => Math.max(2, screen_ratio.call(window) as number),
  });
}
export {};
