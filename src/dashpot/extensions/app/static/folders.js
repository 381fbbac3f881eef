// Folders: saved projects, lots, and recently opened ones.
import { $, createElement, field, status, words } from "./dom.js";
import { openFiles } from "./files.js";
import { LOT, remember, restore, state } from "./job.js";
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
  lot.uploadFiles(head);
}

async function showProject(/** @type {any} */ head) {
  const { tests, hammers, job, joint, temperatures, reading, reading_impact } = head;
  restore({ lot: state.lot });
  Object.assign(state.job, { ...job, hammer: { ...state.job.hammer, ...job.hammer } });
  state.joint = joint && hammers.length > 0;
  field("folder").value = head.folder;
  await openFiles([...tests, ...hammers], (/** @type {string} */ id) => {
    const i = tests.findIndex((/** @type {{id: string}} */ entry) => entry.id === id);
    const temperature = temperatures[Math.min(i, temperatures.length - 1)];
    return i < 0
      ? { options: reading_impact }
      : { options: reading, together: tests.length > 1, temperature: temperature };
  });
}

/** Open a test of the lot with the options of its row, by hash and part of its file. */
export async function openRow(/** @type {string} */ which) {
  const [sha256, ...part] = which.split(" ");
  refuse("", "file");
  try {
    const { head } = await send("row", { folder: state.lot, sha256, part: part.join(" ") });
    Object.assign(state.job, head.job, { time_limits: {} });
    if (state.files.some((entry) => entry.id === head.files[0].id)) {
      state.current = head.files[0].id;
      fileList();
      settle();
    } else {
      const { options = {}, specimen } = head.files[0];
      await openFiles(head.files, () => ({ options, specimen }));
    }
  } catch (error) {
    refuse(words(error), "file");
  }
}

/** Show the recently saved or opened folders. */
export async function list() {
  const { head } = await send("recent", {}).catch(() => ({ head: { recent: [] } }));
  $("recent").hidden = !head.recent.length;
  $("recent-list").replaceChildren(
    ...head.recent.map((/** @type {{folder: string, name: string, when: string}} */ entry) => {
      const when = new Date(entry.when).toLocaleDateString(undefined, { dateStyle: "medium" });
      const open = createElement(
        "button",
        { class: "link", "data-folder": entry.folder },
        entry.name,
      );
      return createElement(
        "li",
        {},
        open,
        createElement("span", { class: "soft" }, entry.folder),
        when,
      );
    }),
  );
}
