// The viewer, in place of a still picture: a page in a frame of its own, made when it comes into
// view. Until it has drawn, where it cannot, and in print the picture stays.

function showViewer(figure) {
  const text = (name) => document.getElementById(`viewer-${name}`).textContent;
  const page = new TextDecoder().decode(
    Uint8Array.from(atob(text("page")), (letter) => letter.charCodeAt(0)));
  const frame = document.createElement("iframe");
  frame.title = "What was planned, in 3D";
  // The frame asks here for what a server would tell.
  frame.lapwing = {
    welcome: text("told"),
    blob: (name) => document.getElementById(`viewer-${name}`)?.textContent ?? null,
  };
  frame.addEventListener("drawn", () => { figure.classList.add("drawn"); });
  // Nothing here may look like the tags of this page's own scripts.
  const element = (name, content) => `<${name}>${content}</${name}>`;
  frame.srcdoc = page
    .replace('<link rel="stylesheet" href="app.css">', () => element("style", text("style")))
    .replace(new RegExp("<(script) defer[^>]*></\\1>"), "")
    .replace("</body>", () => `${element("script", text("script"))}</body>`);
  figure.append(frame);
}

for (const figure of document.querySelectorAll("figure.viewed")) {
  new IntersectionObserver((entries, watch) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watch.disconnect();
    showViewer(figure);
  }, { rootMargin: "200px" }).observe(figure);
}
