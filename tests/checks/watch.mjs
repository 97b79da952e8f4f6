// watch.mjs RIGTWIN RIG_CONTROLLER FOLDER [SCREENSHOTS] -- see watch.bash. Drives Chromium through its debugging pipe.
import {spawn} from "node:child_process";
import {mkdirSync, readFileSync, writeFileSync} from "node:fs";

const [rigtwin, controller, folder, screenshots] = process.argv.slice(2);
const processes = [];
let complaints = 0;
let browser = null;

function start(program, words, options = {}) {
  const child = spawn(program, words, {stdio: ["ignore", "pipe", "pipe"], ...options});
  child.text = "";
  for (const stream of [child.stdout, child.stderr]) if (stream) stream.on("data", (data) => { child.text += data; });
  child.gone = new Promise((resolve) => { child.on("exit", resolve); });
  processes.push(child);
  return child;
}

const pause = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

/// The first value of `look` that is true. A time-out only ends what hangs.
async function until(what, look) {
  for (let i = 0; i < 600; ++i) {
    const seen = await look();
    if (seen) return seen;
    await pause(50);
  }
  throw new Error("never: " + what);
}

function check(what, holds) {
  console.log((holds ? "  " : "NOT: ") + what);
  if (!holds) ++complaints;
}

/// A page of a headless browser.
class Page {
  static async open(width, height) {
    const page = new Page();
    const words = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync",
      `--user-data-dir=${folder}/profile`, "--remote-debugging-pipe", "about:blank"];
    page.browser = start("chromium", words, {stdio: ["ignore", "pipe", "pipe", "pipe", "pipe"]});
    page.waiting = new Map();
    page.number = 0;
    let text = "";
    page.browser.stdio[4].on("data", (data) => {
      text += data;
      for (let end = text.indexOf("\0"); end >= 0; end = text.indexOf("\0")) {
        const message = JSON.parse(text.slice(0, end));
        text = text.slice(end + 1);
        const done = page.waiting.get(message.id);
        if (!done) continue;
        page.waiting.delete(message.id);
        if (message.error) done.fail(new Error(message.error.message)); else done.resolve(message.result);
      }
    });
    const {targetId} = await page.send("Target.createTarget", {url: "about:blank"});
    page.session = (await page.send("Target.attachToTarget", {targetId, flatten: true})).sessionId;
    await page.resize(width, height);
    return page;
  }
  send(method, params = {}) {
    const id = ++this.number;
    this.browser.stdio[3].write(JSON.stringify({id, method, params, sessionId: this.session}) + "\0");
    return new Promise((resolve, fail) => { this.waiting.set(id, {resolve, fail}); });
  }
  async resize(width, height) {
    await this.send("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: 1, mobile: false});
  }
  async evaluate(expression) {
    const {result, exceptionDetails} = await this.send("Runtime.evaluate", {expression, returnByValue: true});
    if (exceptionDetails) throw new Error(expression + ": " + exceptionDetails.text);
    return result.value;
  }
  body(name) { return this.evaluate(`document.body ? document.body.dataset.${name} : ""`); }
  text(id) { return this.evaluate(`document.getElementById("${id}").innerText`); }
  comesTo(name, value) { return until(`${name} ${value}`, async () => (await this.body(name)) === value); }
  press(ask) { return this.evaluate(`document.querySelector('[data-ask="${ask}"]').click()`); }
  /// Presses until the rig is in one of the states: a busy machine may take a second press for a first one.
  async ask(word, states) {
    await until(`${word}: ${states}`, async () => {
      if (states.includes(await this.body("state"))) return true;
      await this.press(word);
      return false;
    });
  }
  isEnabled(ask) { return this.evaluate(`!document.querySelector('[data-ask="${ask}"]').disabled`); }
  /// So that it writes nothing any more.
  async close() {
    this.session = undefined;
    await this.send("Browser.close");
    await this.browser.gone;
  }
  async shot(name) {
    if (!screenshots) return;
    mkdirSync(screenshots, {recursive: true});
    const {data} = await this.send("Page.captureScreenshot", {format: "png"});
    writeFileSync(`${screenshots}/${name}.png`, Buffer.from(data, "base64"));
  }
}

/// What the first panel shows, as text; how many of its pixels are coloured.
const drawing = `(function () {
  const canvas = document.querySelector(".panel canvas");
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let coloured = 0, hash = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    if (pixels[i + 3] > 0 && Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 60) ++coloured;
    hash = (hash * 31 + pixels[i] + 7 * pixels[i + 1] + 13 * pixels[i + 2]) | 0;
  }
  return {coloured: coloured, hash: hash};
})()`;

const patient = "[controller]\nlate_in_a_row = 1000000\n[supervision]\ngap = 1.0\n";  // this machine is busy
const hil = readFileSync("host_sim/rigs/paper_hil_fdva.toml", "utf8");
const calm_rig = `${folder}/calm.toml`, wild_rig = `${folder}/wild.toml`;
writeFileSync(calm_rig, hil + patient);
writeFileSync(wild_rig, hil.replace("[limits]", "[limits]\nenergy_gain = 0.3") + patient);

async function main() {
  const socket = `${folder}/control`;
  const watch = start(rigtwin, ["watch", "--port", "0", "--receive", "127.0.0.1:0", "--socket", socket]);
  await until("rigtwin watch listens", () => watch.text.includes("requests"));
  const url = watch.text.split("\n")[0];
  const port = /UDP 127\.0\.0\.1:(\d+)/.exec(watch.text)[1];
  let runs = 0;
  const control = (rig) => start(controller, ["--rig", rig, "--simulated", "--no-realtime", "--wait", "--duration", "600", "--socket", socket,
    "--publish", `127.0.0.1:${port}`, "--out", `${folder}/run${++runs}.csv`]);

  const page = await Page.open(1280, 800);
  browser = page;
  await page.send("Page.navigate", {url});
  await page.comesTo("link", "waiting");
  check("before a controller: nothing can be asked but stop",
    !(await page.isEnabled("arm")) && (await page.isEnabled("stop")));

  console.log("a run");
  const first = control(calm_rig);
  await page.comesTo("link", "live");
  await page.comesTo("state", "idle");
  check("in idle: arm, not start", (await page.isEnabled("arm")) && !(await page.isEnabled("start")));
  await until("the button asks whether that is meant", async () => {
    await page.press("arm");
    return (await page.text("requests")).includes("Sure?") || (await page.text("answer")).startsWith("Asked");
  });
  check("one press of Arm asks for nothing", (await page.text("answer")).startsWith("Nothing asked yet"));
  await page.ask("arm", ["armed"]);
  await page.ask("start", ["running"]);
  await pause(2000);
  // A cable that is out says nothing: no end of the connection, only silence.
  watch.kill("SIGSTOP");
  await page.comesTo("link", "lost");
  check("a silent server is a lost one: nothing can be asked, values are stale",
    (await page.evaluate("[...document.querySelectorAll('[data-ask], [data-any]')].every((b) => b.disabled)")) &&
    (await page.evaluate("document.body.classList.contains('stale')")) && (await page.text("alarm")).includes("red button"));
  watch.kill("SIGCONT");
  await page.comesTo("link", "live");
  check("it goes on when the server speaks again", !(await page.evaluate("document.body.classList.contains('stale')")) && (await page.isEnabled("hold")));
  await pause(4000);
  const before = await page.evaluate(drawing), frames = Number(await page.body("frames"));
  await pause(1000);
  const after = await page.evaluate(drawing);
  check(`traces are drawn (${after.coloured} pixels) and move`, after.coloured > 500 && before.hash !== after.hash);
  check("frames keep coming", Number(await page.body("frames")) > frames);
  check("four groups of traces", (await page.body("drawn")) === "4");
  check("margins of energy, force and stroke", /Energy[\s\S]*Force[\s\S]*Stroke/.test(await page.text("gauges")));
  check("ages of F and x_act", /x_act[\s\S]*ms/.test(await page.text("age-bars")) && /F[\s\S]*ms/.test(await page.text("age-bars")));
  check("the loop's histogram", /wake-up[\s\S]*step[\s\S]*sample age/.test(await page.text("spans")));
  await page.shot("running-1280x800");
  check("1280x800: nothing is cut off",
    await page.evaluate("document.documentElement.scrollWidth <= 1280 && document.documentElement.scrollHeight <= 800"));
  await page.resize(800, 1280);
  await pause(500);
  await page.shot("running-800x1280");
  check("800x1280: no scrolling sideways", await page.evaluate("document.documentElement.scrollWidth <= 800"));
  await page.resize(390, 844);
  await pause(500);
  check("390x844: no scrolling sideways", await page.evaluate("document.documentElement.scrollWidth <= 390"));
  await page.resize(1280, 800);
  await page.evaluate(`document.getElementById("mark").value = "<img src=x onerror=alert(1)>";
    document.getElementById("mark-form").requestSubmit()`);
  await until("the mark is taken", async () => (await page.text("answer")).includes("taken"));
  await page.press("stop");
  check("stop takes one press", !(await page.text("stop")).includes("Sure?"));
  await page.comesTo("state", "safe");
  check("and its reason is shown", (await page.text("why")).startsWith("Ended by stop requested"));
  first.kill("SIGTERM");
  await page.comesTo("link", "ended");
  check("the end of a controller is no alarm", (await page.text("why")).startsWith("The controller has ended"));

  console.log("a trip");
  const second = control(wild_rig);
  await page.comesTo("link", "live");
  await page.comesTo("state", "idle");
  await page.ask("arm", ["armed"]);
  await page.ask("start", ["ready", "running", "safe"]);
  await page.comesTo("state", "safe");
  check("the trip with its reason: " + await page.text("why"),
    (await page.body("reason")) === "energy" && /^Ended by energy \([\d.]+, limit 0\.3\)/.test(await page.text("why")));
  check("it stands in the list", (await page.text("events")).includes("safe: energy ("));
  await pause(1000);
  await page.shot("trip-1280x800");

  console.log("the controller is gone");
  second.kill("SIGKILL");
  await page.comesTo("link", "gone");
  check("it says so: " + (await page.text("alarm")).trim(), (await page.text("alarm")).includes("No values from the controller"));
  check("values are stale", (await page.evaluate("document.body.classList.contains('stale')")) && (await page.text("why")).startsWith("STALE"));
  check("nothing can be asked but stop", (await page.evaluate("[...document.querySelectorAll('[data-ask], [data-any]')].filter((b) => !b.disabled).map((b) => b.id).join()")) === "stop");
  const frozen = await page.evaluate(drawing);
  await pause(1000);
  check("the traces stand still", (await page.evaluate(drawing)).hash === frozen.hash);
  await page.shot("gone-1280x800");
  await page.press("stop");
  await until("an answer", async () => (await page.text("answer")).includes("no controller listens there"));
  check("stop says that nobody has heard it", await page.evaluate("document.getElementById('answer').className === 'refused'"));

  console.log("the server is gone");
  const errors = await page.body("errors");
  watch.kill("SIGTERM");
  check("it ends with status 0", (await watch.gone) === 0);
  await page.comesTo("link", "lost");
  check("it says so: " + (await page.text("alarm")).trim(), (await page.text("alarm")).includes("The connection to rigtwin watch has been lost"));
  check("nothing can be asked", (await page.evaluate("[...document.querySelectorAll('[data-ask], [data-any]')].every((b) => b.disabled)")));
  await page.shot("lost-1280x800");
  check("no error in the page", errors === "0" && (await page.body("errors")) === "0");
  check("nothing was fetched", (await page.body("requests")) === "0");
}

for (const signal of ["SIGTERM", "SIGINT", "SIGHUP"]) {
  process.on(signal, () => {  // nothing that was started here goes on
    for (const child of processes) child.kill("SIGKILL");
    process.exit(1);
  });
}

try {
  await main();
} catch (error) {
  console.log("NOT: " + error.message);
  ++complaints;
  for (const child of processes) if (child.spawnfile !== "chromium") console.log(child.text.split("\n").slice(-12).join("\n"));
}
if (browser) await Promise.race([browser.close(), pause(5000)]);
for (const child of processes) if (child.exitCode === null) child.kill("SIGKILL");
process.exit(complaints === 0 ? 0 : 1);
