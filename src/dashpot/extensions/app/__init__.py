"""Local web app: a page in the browser, served on this machine."""
