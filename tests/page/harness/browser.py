# SPDX-License-Identifier: Apache-2.0
"""Chromium, headless, one for each test file; each test opens a tab of its own. What the browser logged is read here:
messages of the console, and each frame of each WebSocket."""
import json
import os
import shutil
import tempfile

from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.service import Service

PATIENCE = 20.0  # s: a page that lets a test wait longer hangs
FLAGS = ("--headless=new", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--window-size=1400,900", "--force-device-scale-factor=1",
         "--host-resolver-rules=MAP evil.test 127.0.0.1")


class Browser:
    """The browser and its driver. `home`: its folder for profile, cache and settings."""

    def __init__(self):
        self.home = tempfile.mkdtemp(prefix="chimera-page-browser-")
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for flag in (*FLAGS, f"--user-data-dir={self.home}/profile"):
            options.add_argument(flag)
        if os.geteuid() == 0:  # Chromium refuses to separate its processes for root
            options.add_argument("--no-" + "sand" + "box")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        environment = dict(os.environ, HOME=self.home, XDG_CONFIG_HOME=self.home, XDG_CACHE_HOME=self.home)
        try:
            self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver", env=environment), options=options)
        except BaseException:
            shutil.rmtree(self.home, ignore_errors=True)
            raise
        self.driver.set_script_timeout(PATIENCE + 10)
        self.driver.set_page_load_timeout(PATIENCE + 10)
        self.first = self.driver.current_window_handle

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.home, ignore_errors=True)

    def new_tab(self):
        """Opens an empty tab and forgets what earlier tabs logged."""
        self.driver.switch_to.window(self.first)
        self.driver.switch_to.new_window("tab")
        self.messages()
        self.driver.get_log("performance")

    def close_tabs(self):
        for handle in self.driver.window_handles:
            if handle != self.first:
                self.driver.switch_to.window(handle)
                self.driver.close()
        self.driver.switch_to.window(self.first)

    def command(self, name, **parameters):
        """A command of the protocol of its developer tools, for the present tab."""
        return self.driver.execute_cdp_cmd(name, parameters)

    def messages(self):
        """What reached the console since the last call: (level, text)."""
        return [(entry["level"], entry["message"]) for entry in self.driver.get_log("browser")]

    def notices(self):
        """What the network reported since the last call: (method, parameters)."""
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"].startswith("Network."):
                yield message["method"], message["params"]

    def await_that(self, condition, what):
        """Waits until the JavaScript expression `condition` is true in the present tab, and returns its value. It is
        evaluated now and after each change of the document."""
        script = f"""
            const done = arguments[0], judge = () => {{ try {{ return {condition}; }} catch (_) {{ return null; }} }};
            const now = judge();
            if (now) return done(now);
            let late;
            const observer = new MutationObserver(() => {{
              const value = judge();
              if (value) {{ observer.disconnect(); clearTimeout(late); done(value); }}
            }});
            late = setTimeout(() => {{ observer.disconnect(); done(null); }}, {PATIENCE * 1e3});
            observer.observe(document, {{attributes: true, childList: true, characterData: true, subtree: true}});"""
        try:
            found = self.driver.execute_async_script(script)
        except WebDriverException as error:
            raise AssertionError(f"{what}: {error.msg}") from None
        assert found, f"{what} did not come true within {PATIENCE:.0f} s: {condition}\n{self.outline()}"
        return found

    def outline(self):
        """Attributes of the root and the text of the page: what a failure shows."""
        return self.driver.execute_script(
            "return location.href.replace(/#.*/, '') + ' ' + JSON.stringify(document.documentElement.dataset) + '\\n' +"
            " (document.body ? document.body.innerText.slice(0, 3000) : '')")
