// Lets Node load the package of Rapier, which is made for bundlers: its modules do not say that they are
// some, and leave out how the files' names end that they import.
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
