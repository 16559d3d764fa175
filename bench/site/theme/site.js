// The menu is folded on narrow screens, where it is above the page.
const menu = document.querySelector('.menu');
if (matchMedia('(max-width: 899px)').matches) menu.open = false;

// Full-text search in the pages and the reference. Pages without a server cannot fetch files, so the index is a
// script, which is loaded when the field gets the focus.
const field = document.querySelector('.search input');
const hits = document.querySelector('.search ol');
const kMaxHits = 12;

function loadScript(name) {
  return new Promise((resolve, reject) => {
    const script = document.createElement('script');
    script.src = `${field.dataset.base}/${name}`;
    script.onload = resolve;
    script.onerror = reject;
    document.head.append(script);
  });
}

let index;
function loadIndex() {
  index ??= loadScript('lunr.js').then(() => loadScript('search_index.js')).then(() => lunr(function () {
    this.ref('location');
    this.field('title', {boost: 10});
    this.field('text');
    for (const entry of WINNOW_SEARCH) this.add({...entry, title: entry.title.replaceAll('::', ' ')});
  }));
  return index;
}

// Returns the entries that contain every word, of which the last may be incomplete; best first.
async function search(words) {
  const found = await loadIndex();
  const matches = found.query(query => words.forEach((word, i) => {
    const wildcard = i + 1 === words.length ? lunr.Query.wildcard.TRAILING : lunr.Query.wildcard.NONE;
    query.term(word, {usePipeline: false, wildcard, presence: lunr.Query.presence.OPTIONAL});
    query.term(lunr.stemmer(new lunr.Token(word)).toString(), {usePipeline: false, boost: 2});
  }));
  const entries = new Map(WINNOW_SEARCH.map(entry => [entry.location, entry]));
  const hasAll = entry => words.every(word => `${entry.title} ${entry.text}`.toLowerCase().includes(word));
  const all = matches.map(match => entries.get(match.ref));
  return all.filter(hasAll).concat(all.filter(entry => !hasAll(entry))).slice(0, kMaxHits);
}

async function showHits() {
  const text = field.value;
  const words = text.toLowerCase().match(/[\w:]+/g) ?? [];
  const entries = words.length ? await search(words) : [];
  if (field.value !== text) return;
  hits.replaceChildren(...entries.map(entry => {
    const link = document.createElement('a');
    link.href = `${field.dataset.base}/${entry.location}`;
    link.textContent = entry.title;
    const line = document.createElement('li');
    line.append(link);
    if (entry.page !== entry.title) {
      line.append(document.createElement('small'));
      line.lastChild.textContent = entry.page;
    }
    return line;
  }));
  if (words.length && !entries.length) hits.textContent = 'No page contains these words.';
  hits.hidden = !words.length;
}

field.addEventListener('focus', loadIndex);
field.addEventListener('input', showHits);
field.form.addEventListener('submit', event => {
  event.preventDefault();
  hits.querySelector('a')?.click();
});
document.addEventListener('keydown', event => {
  if (event.key === 'Escape') hits.hidden = true;
  if (event.key === '/' && document.activeElement === document.body) {
    event.preventDefault();
    field.focus();
  }
});

// For tests: #search=words shows the hits of these words.
if (location.hash.startsWith('#search=')) {
  field.value = decodeURIComponent(location.hash.slice('#search='.length));
  showHits().then(() => { document.body.dataset.hits = hits.children.length; });
}

// For tests: the width of the page beyond the right edge, and its height.
if (location.hash === '#check') {
  document.body.dataset.beyond =
    document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.body.dataset.height = document.documentElement.scrollHeight;
}
