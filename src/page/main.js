// A page with data is a report; one without is live.
const held = $("data");
document.body.className = held ? "report" : "live";
if (held) new Report(JSON.parse(held.textContent));
else new Live();
