// Folders: projects that were kept, lots, and what was opened last.
import { $, field, made, status, words } from "./dom.js";
import { opened } from "./files.js";
import { become, LOT, remember, state } from "./job.js";
import * as lot from "./lot.js";
import { settle } from "./questions.js";
import { fileList, views } from "./shown.js";
import { refuse } from "./verdict.js";
import { send } from "./wire.js";

/** Open the project or the lot in a folder. */
export async function openFolder(/** @type {string} */ folder) {
  refuse("", "file");
  document.body.classList.remove("folders");
  status("opening the folder");
  try {
    const { head } = await send("folder", { folder });
    if (head.kind === "lot") showTable(head);
    else await showProject(head);
  } catch (error) {
    refuse(words(error), "file");
    status("not opened");
  }
  await list();
}

function showTable(/** @type {any} */ head) {
  state.lot = head.folder;
  state.current = LOT;
  remember();
  fileList();
  views();
  lot.take(head);
}

async function showProject(/** @type {any} */ head) {
  const { tests, hammers, job, joint, temperatures, reading, reading_impact } = head;
  become({ lot: state.lot });
  Object.assign(state.job, { ...job, hammer: { ...state.job.hammer, ...job.hammer } });
  state.joint = joint && hammers.length > 0;
  field("folder").value = head.folder;
  await opened([...tests, ...hammers], (/** @type {string} */ id) => {
    const i = tests.findIndex((/** @type {{id: string}} */ one) => one.id === id);
    const warmth = temperatures[Math.min(i, temperatures.length - 1)];
    return i < 0
      ? { options: reading_impact }
      : { options: reading, together: tests.length > 1, temperature: warmth };
  });
}

/** Open a test of the lot, with the choices that its row was made by: hash and part of its file. */
export async function openRow(/** @type {string} */ which) {
  const [sha256, ...part] = which.split(" ");
  refuse("", "file");
  try {
    const { head } = await send("row", { folder: state.lot, sha256, part: part.join(" ") });
    Object.assign(state.job, head.job, { time_limits: {} });
    if (state.files.some((one) => one.id === head.files[0].id)) {
      state.current = head.files[0].id;
      fileList();
      settle();
    } else {
      const { options = {}, specimen } = head.files[0];
      await opened(head.files, () => ({ options, specimen }));
    }
  } catch (error) {
    refuse(words(error), "file");
  }
}

/** The folders that were kept or opened last. */
export async function list() {
  const { head } = await send("recent", {}).catch(() => ({ head: { recent: [] } }));
  $("recent").hidden = !head.recent.length;
  $("recent-list").replaceChildren(
    ...head.recent.map((/** @type {{folder: string, name: string, when: string}} */ one) => {
      const when = new Date(one.when).toLocaleDateString(undefined, { dateStyle: "medium" });
      const open = made("button", { class: "link", "data-folder": one.folder }, one.name);
      return made("li", {}, open, made("span", { class: "soft" }, one.folder), when);
    }),
  );
}
