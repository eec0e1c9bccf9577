// Search without a server: a browser starts no worker from a file, so that a page read from disk lets a hidden frame do its work.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      const inside = this.frame.contentWindow;
      inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      inside.importScripts = async (...urls) => {
        for (const each of urls) await script(inside.document, each);
      };
      this.ready = script(inside.document, url);
    }

    postMessage(data) {
      const inside = this.frame.contentWindow;
      this.ready.then(() => inside.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };

  const script = (page, url) =>
    new Promise((loaded, failed) => {
      const element = page.createElement("script");
      Object.assign(element, { src: url, onload: loaded, onerror: failed });
      page.body.append(element);
    });
}
