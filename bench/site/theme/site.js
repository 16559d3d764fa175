// The menu is folded on narrow screens, where it is above the page.
const menu = document.querySelector('.menu');
if (matchMedia('(max-width: 899px)').matches) menu.open = false;

// For tests: the width of the page beyond the right edge, and its height.
if (location.hash === '#check') {
  document.body.dataset.beyond =
    document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.body.dataset.height = document.documentElement.scrollHeight;
}
