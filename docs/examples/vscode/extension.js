// Starts `aos language-server` for SDL documents.
const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = () => {
  const command = workspace.getConfiguration("aos").get("command");
  const server = { command, args: ["language-server"] };
  client = new LanguageClient("aos", "AOS", server, {
    documentSelector: [{ scheme: "file", language: "aos" }],
  });
  return client.start();
};

exports.deactivate = () => client?.stop();
