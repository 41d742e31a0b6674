"""All operations of the gateway, in the order of the documentation."""

from aos_gateway.operations import EVENT_STREAM, Operation, operation
from aos_gateway.resources import documents, reading, run_files, study, writing
from aos_gateway.resources.state_picture import state_picture

_ARCHIVE = "an archive of documents, or one document"

OPERATIONS: tuple[Operation, ...] = (
    operation("GET", "/v1", reading.index),
    operation("GET", "/v1/projects", writing.projects),
    operation("POST", "/v1/projects", writing.upload, upload=_ARCHIVE, status=201),
    operation("POST", "/v1/checks", writing.check, upload=_ARCHIVE),
    operation("GET", "/v1/runs", reading.runs),
    operation("POST", "/v1/runs", writing.start, status=201),
    operation("GET", "/v1/runs/{run}", reading.run),
    operation("GET", "/v1/runs/{run}/services", run_files.services),
    operation("GET", "/v1/runs/{run}/logs/{service}", run_files.log, media="text/plain"),
    operation("GET", "/v1/runs/{run}/bundles", documents.bundles),
    operation("POST", "/v1/runs/{run}/bundles", writing.push, upload=_ARCHIVE),
    operation("POST", "/v1/runs/{run}/stop", writing.end),
    operation("POST", "/v1/runs/{run}/missions", writing.start_next, status=201),
    operation("GET", "/v1/missions", reading.missions),
    operation("GET", "/v1/missions/{mission}", reading.mission),
    operation("POST", "/v1/missions/{mission}/stop", writing.stop),
    operation("POST", "/v1/missions/{mission}/steering", writing.steer),
    operation("GET", "/v1/missions/{mission}/trace", reading.trace),
    operation("GET", "/v1/missions/{mission}/decisions", reading.decisions),
    operation("GET", "/v1/missions/{mission}/decisions/{step}", reading.decision),
    operation("GET", "/v1/missions/{mission}/beliefs", reading.beliefs),
    operation("GET", "/v1/missions/{mission}/activations", reading.activations),
    operation("GET", "/v1/missions/{mission}/world", run_files.pictures),
    operation("GET", "/v1/missions/{mission}/world/{step}", run_files.picture, media="image/png"),
    operation("GET", "/v1/missions/{mission}/documents", documents.documents),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/why", study.why),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/tree", study.tree),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/picture", state_picture, media="image/svg+xml"),
    operation("POST", "/v1/missions/{mission}/decisions/{step}/whatif", study.what_if),
    operation("GET", "/v1/events", reading.events, media=EVENT_STREAM, gives=None),
)
