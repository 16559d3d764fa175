// Lets Node load Rapier's npm package, which is made for bundlers: it does not declare its files as modules,
// and its imports omit the file extension.
export async function resolve(specifier, context, next) {
  for (const end of ['', '.js', '/index.js']) {
    try {
      const found = await next(specifier + end, context);
      const isModule = found.url.includes('/@dimforge/') && found.url.endsWith('.js');
      return isModule ? {...found, format: 'module'} : found;
    } catch (error) {
      if (end === '/index.js') throw error;
    }
  }
}
