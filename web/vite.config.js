import { defineConfig } from 'vite';

// A report is one file that is mailed and opened years later without a network: put the script and the style sheet into
// the page itself. Function replacements, since the bundle may contain "$&".
function single_file() {
  return {
    name: 'veridyn-single-file',
    enforce: 'post',
    generateBundle(_options, bundle) {
      const page = Object.values(bundle).find((file) => file.fileName.endsWith('.html'));
      let html = String(page.source);
      for (const file of Object.values(bundle)) {
        if (file === page) continue;
        const name = file.fileName.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
        const before = html;
        if (file.type === 'chunk') {
          const code = file.code.replace(/<\/script/gi, '<\\/script').replace(/<!--/g, '<\\!--');
          html = html.replace(new RegExp(`<script[^>]*src="[^"]*${name}"[^>]*></script>`), '');
          html = html.replace('</body>', () => `<script type="module">${code.trim()}</script>\n</body>`);
        } else if (file.fileName.endsWith('.css')) {
          html = html.replace(new RegExp(`<link[^>]*href="[^"]*${name}"[^>]*>`), () => `<style>${file.source}</style>`);
        }
        if (html === before) this.error(`${file.fileName} cannot be put into the page`);
        delete bundle[file.fileName];
      }
      for (const marker of ['@@VERIDYN_TITLE@@', '@@VERIDYN_STATIC@@', '@@VERIDYN_DOCUMENT@@']) {
        if (html.split(marker).length !== 2) this.error(`${marker} must stand in the page exactly once`);
      }
      page.source = html;
    },
  };
}

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: 1e9,
    cssCodeSplit: false,
    reportCompressedSize: false,
    rollupOptions: { input: 'report.html' },
  },
  plugins: [single_file()],
});
