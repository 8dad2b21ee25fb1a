"""Messages between workers without the driver: hits on rows that others own, and who has nothing left to fire.

Each message holds what has gathered up since the one before, so at most one to each worker is under way. The work is at an end
where all workers have nothing to fire, and each has taken all hits that it was sent: every message tells how many hits its
sender has sent there, and has taken from there. Of three workers, two may take it to be at an end while the third is about to
send hits to one of them; what they leave is fired afterwards.
"""

import threading
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..algorithms.firing.own_rows import AbstractPost

NAME = "radiosity_hits"  # of the handler of messages
KEPT = 4  # boxes of a worker; messages for older ones come too late
BUSY, IDLE, GONE = range(3)  # a worker that has something to fire; that waits for hits; that has returned


@dataclass
class Peer:
    """Another worker, as one sees it: what it has sent, and what it is sent.

    Attributes:
        hits: those of it that were not taken yet; 0 where there are none.
        sent, taken: hits that it has sent here in all, and has taken from here, as it says.
        state: as it says.
        took: hits of it that were taken here.
        waiting: hits for it that are not under way yet; None where there are none.
        gave: hits for it in all.
        told: the last message: hits given and taken by then, and the state here.
        under_way: True while a message is.
    """

    hits: Any = 0
    sent: int = 0
    taken: int = 0
    state: int = BUSY
    took: int = 0
    waiting: np.ndarray | None = None
    gave: int = 0
    told: tuple[int, int, int] = (0, 0, BUSY)
    under_way: bool = False


@dataclass
class Box:
    """What has come for a worker, and is to be sent.

    Attributes:
        peers: by their numbers.
        ended: True once the driver or a lost message has ended the work.
        changed: of all these.
    """

    peers: dict[int, Peer] = field(default_factory=dict)
    ended: bool = False
    changed: threading.Condition = field(default_factory=threading.Condition)

    def peer(self, number: int) -> Peer:
        return self.peers.setdefault(number, Peer())


_boxes: dict[str, OrderedDict[str, Box]] = {}
_made = threading.Lock()


def box(address: str, key: str) -> Box:
    """Return the box of a worker for a piece of work."""
    with _made:
        boxes = _boxes.setdefault(address, OrderedDict())
        found = boxes.setdefault(key, Box())
        while len(boxes) > KEPT:
            boxes.popitem(last=False)
        return found


def open_for(worker: Any) -> None:
    """Let a worker of Dask receive messages."""

    async def receive(key: str, sender: int, hits: Any, sent: int, taken: int, state: int) -> str:
        into = box(worker.address, key)
        with into.changed:
            peer = into.peer(sender)
            if hits is not None:
                peer.hits = peer.hits + np.asarray(hits).astype(np.uint64)
            peer.sent, peer.taken, peer.state = sent, taken, state
            into.changed.notify_all()
        return "OK"

    worker.handlers[NAME] = receive


async def end(key: str, dask_worker: Any) -> None:
    """End a piece of work on a worker early: it returns what it has.

    `Client.run` gives it the worker, by that name, and waits for all functions that are not asynchronous.
    """
    into = box(dask_worker.address, key)
    with into.changed:
        into.ended = True
        into.changed.notify_all()


async def deliver(worker: Any, address: str, hits: np.ndarray | None, message: dict) -> None:
    """Send a message from a worker of Dask to another one, and wait until it has come."""
    from distributed.protocol.serialize import to_serialize

    given = None if hits is None else to_serialize(hits)
    await getattr(worker.rpc(address), NAME)(hits=given, **message)


class WorkerPost(AbstractPost):
    """The post of one worker of several.

    Args:
        worker: of Dask, this one.
        key: of the piece of work.
        own: the number of this worker. addresses: of all of them, by number.
    """

    def __init__(self, worker: Any, key: str, own: int, addresses: list[str]):
        self.worker, self.key, self.own, self.addresses = worker, key, own, addresses
        self.box, self.state = box(worker.address, key), BUSY
        self.others = [number for number in range(len(addresses)) if number != own]
        for number in self.others:
            self.box.peer(number)

    def send(self, hits: list[np.ndarray]) -> None:
        with self.box.changed:
            self.state = BUSY
            for number in self.others:
                peer, more = self.box.peers[number], hits[number]
                if peer.state == GONE:
                    continue
                peer.gave += int(more.sum(dtype=np.int64))
                peer.waiting = more.astype(np.uint32) if peer.waiting is None else peer.waiting + more.astype(np.uint32)
        self._set_off()

    def take(self) -> np.ndarray | int:
        total: Any = 0
        with self.box.changed:
            for number in self.others:
                peer = self.box.peers[number]
                total = total + peer.hits
                peer.took += int(np.sum(peer.hits))
                peer.hits = 0
        return total

    def wait(self, seconds: float) -> bool:
        self._become(IDLE)
        with self.box.changed:
            self.box.changed.wait_for(lambda: self._come() or self._over(), seconds)
            return self._come() and not self.box.ended

    def close(self) -> None:
        """Tell the others that nothing more is taken here."""
        self._become(GONE)

    def _become(self, state: int) -> None:
        with self.box.changed:
            self.state = state
        self._set_off()

    def _come(self) -> bool:
        return any(np.ndim(self.box.peers[number].hits) for number in self.others)

    def _over(self) -> bool:
        peers = [self.box.peers[number] for number in self.others]
        return self.box.ended or all(
            peer.state == GONE or (peer.state == IDLE and peer.taken == peer.gave and peer.took == peer.sent) for peer in peers
        )

    def _set_off(self) -> None:
        """Begin to send to all to whom nothing is under way."""
        with self.box.changed:
            free = [number for number in self.others if not self.box.peers[number].under_way]
            for number in free:
                self.box.peers[number].under_way = True
        for number in free:
            self.worker.loop.add_callback(self._send, number)

    async def _send(self, number: int) -> None:
        """Send messages to a worker until there is nothing new."""
        peer = self.box.peers[number]
        while True:
            with self.box.changed:
                news = (peer.gave, peer.took, self.state)
                if news == peer.told or self.box.ended:
                    peer.under_way = False
                    self.box.changed.notify_all()
                    return
                hits, peer.waiting, peer.told = peer.waiting, None, news
            message = {"key": self.key, "sender": self.own, "sent": news[0], "taken": news[1], "state": news[2]}
            try:
                await deliver(self.worker, self.addresses[number], hits, message)
            except Exception:  # the other one has gone: what was done here remains whole
                with self.box.changed:
                    peer.under_way, self.box.ended = False, True
                    self.box.changed.notify_all()
                return
