// Animations are large: those of a section load when it is opened, and not before. They are shown when all are there, in one go, so
// that they turn together.
const sections = [...document.querySelectorAll("details")];
for (const section of sections) {
  const load = async () => {
    if (!section.open) return;
    const images = [...section.querySelectorAll("img[data-src]")];
    const sources = images.map((image) => image.dataset.src);
    for (const image of images) image.removeAttribute("data-src");
    await Promise.allSettled(sources.map((source) => {
      const ahead = new Image();
      ahead.src = source;
      return ahead.decode();
    }));
    images.forEach((image, i) => { image.src = sources[i]; });
  };
  section.addEventListener("toggle", load);
  load();
}
// A link into a closed section opens it.
const reveal = () => {
  const target = document.getElementById(location.hash.slice(1));
  for (let section = target?.closest("details"); section; section = section.parentElement.closest("details")) section.open = true;
};
// A phone shows the first of each section, and the rest when asked; other screens and paper show all.
const rests = sections.filter((section) => section.classList.contains("rest"));
const setRests = (open) => rests.forEach((section) => { section.open = open; });
const narrow = matchMedia("screen and (max-width: 700px)");
narrow.addEventListener("change", () => setRests(!narrow.matches));
addEventListener("beforeprint", () => setRests(true));
setRests(!narrow.matches);
addEventListener("hashchange", reveal);
reveal();
// Tables can be searched and opened together; without this script nothing says so.
const tables = sections.filter((section) => section.classList.contains("data"));
for (const tools of document.querySelectorAll(".tools")) {
  tools.hidden = tables.length === 0;
  const [input, button, found] = [tools.querySelector("input"), tools.querySelector("button"), tools.querySelector("output")];
  input.addEventListener("input", () => {
    setRests(true);
    const wanted = input.value.trim().toLowerCase();
    let left = 0;
    for (const section of tables) {
      const named = section.querySelector("summary").textContent.toLowerCase().includes(wanted);
      let rows = 0;
      for (const row of section.querySelectorAll("tbody tr")) {
        row.hidden = !named && !row.textContent.toLowerCase().includes(wanted);
        rows += !row.hidden;
      }
      section.hidden = !named && rows === 0;
      left += !section.hidden;
    }
    found.textContent = wanted ? `${left} of ${tables.length} tables` : "";
  });
  button.addEventListener("click", () => {
    const open = button.getAttribute("aria-pressed") !== "true";
    if (open) setRests(true);
    for (const section of tables) section.open = open;
    button.setAttribute("aria-pressed", String(open));
    button.textContent = open ? "Close all tables" : "Open all tables";
  });
}
