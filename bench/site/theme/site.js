// The menu is folded where it would stand above the page.
const menu = document.querySelector('.menu');
if (matchMedia('(max-width: 899px)').matches) menu.open = false;

// For tests: how far the page reaches beyond the right edge.
if (location.hash === '#check') {
  document.body.dataset.beyond =
    document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.body.dataset.height = document.documentElement.scrollHeight;
}
