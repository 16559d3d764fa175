"""Clusters: the pairs of one partition, on virtual ranks, on threads that communicate like MPI processes, and
on MPI processes if mpi4py is installed."""

import importlib.util
import shutil
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest

import winnow


def boxes_of(count, seed):
    random = np.random.default_rng(seed)
    lower = random.uniform(0, 10, (count, 3)).astype(np.float32)
    return lower, lower + random.uniform(0.1, 1.0, (count, 3)).astype(np.float32)


def true_pairs(names, lower, upper):
    partition = winnow.Partition("BoundsNSquared")
    ids = winnow.ids_of(partition.insert(lower, upper))
    name = dict(zip(ids.tolist(), names.tolist()))
    return {tuple(sorted((name[a], name[b]))) for a, b in partition.self_pairs().tolist()}


def names_of(count):
    return np.random.default_rng(count).permutation(10 * count)[:count].astype(np.uint64)


def refused(status, call, *arguments, **named):
    with pytest.raises(winnow.StatusError) as error:
        call(*arguments, **named)
    assert error.value.status == status


@pytest.mark.parametrize("ranks", [1, 2, 5])
def test_virtual_ranks_find_the_pairs_of_one_partition(ranks):
    names = names_of(400)
    lower, upper = boxes_of(400, 1)
    cluster = winnow.Cluster(ranks=ranks)
    assert cluster.ranks == ranks and cluster.hosted == (0, ranks)
    cluster.add(names, lower, upper, rank=ranks - 1)
    digests = []
    for _ in range(3):
        pairs = cluster.self_pairs("canonical")
        assert pairs.shape[1] == 2 and pairs.dtype == np.uint64
        assert {tuple(p) for p in pairs.tolist()} == true_pairs(names, lower, upper)
        assert cluster.statistics["pairs"] == len(pairs)
        digests.append(cluster.digest())
        seen = 0
        for rank in range(ranks):
            own, low, high = cluster.bodies(rank)
            seen += len(own)
            at = np.array([int(np.flatnonzero(names == name)[0]) for name in own], dtype=int)
            assert np.array_equal(low, lower[at]) and np.array_equal(high, upper[at])
            lower[at] += 0.3
            upper[at] += 0.3
            cluster.move(own, lower[at], upper[at], rank=rank)
        assert seen == 400
    single = winnow.Cluster()
    single.add(names, *boxes_of(400, 1))
    single.self_pairs()
    assert single.digest() == digests[0] and len(digests[0]) == 32
    cluster.self_pairs()
    own = cluster.bodies(0)[0]
    cluster.remove(own[:5], rank=0)
    cluster.self_pairs()
    assert cluster.statistics["bodies"] == 400 - min(5, len(own))


def test_invalid_calls_are_refused():
    lower, upper = boxes_of(3, 2)
    cluster = winnow.Cluster(ranks=2)
    cluster.add([1, 2, 3], lower, upper)
    refused("invalid_key", cluster.add, [3, 4, 5], lower, upper, rank=1)
    refused("invalid_bounds", cluster.add, [7, 8, 9], upper, lower)
    refused("size_mismatch", cluster.add, [7], lower, upper)
    refused("invalid_argument", cluster.add, [7, 8, 9], lower, upper, rank=2)
    refused("invalid_key", cluster.move, [9], lower[:1], upper[:1])
    refused("invalid_key", cluster.remove, [9])
    refused("invalid_argument", cluster.self_pairs, "sorted")
    refused("invalid_argument", winnow.Cluster, ranks=2, structure="Tree")
    refused("invalid_argument", winnow.Cluster, imbalance=0.5)
    with pytest.raises(AttributeError):
        winnow.Cluster(comm=7)


class Threads:
    """The interface of mpi4py's communicators, between threads."""

    def __init__(self, size, breaks_at=None):
        self.size = size
        self.barrier = threading.Barrier(size)
        self.gathered = [None] * size
        self.breaks_at = breaks_at

    def of(self, rank):
        return ThreadRank(self, rank)


class ThreadRank:
    def __init__(self, world, rank):
        self.world, self.rank, self.size, self.calls = world, rank, world.size, 0

    def allgather(self, value):
        self.calls += 1
        if self.calls == self.world.breaks_at:
            self.world.barrier.abort()
            raise ConnectionError("a rank is gone")
        self.world.gathered[self.rank] = value
        self.world.barrier.wait(30)
        gathered = list(self.world.gathered)
        self.world.barrier.wait(30)
        return gathered

    def alltoall(self, values):
        return [row[self.rank] for row in self.allgather(values)]


def run_on_threads(world, work):
    results = [None] * world.size

    def run(rank):
        try:
            results[rank] = work(world.of(rank))
        except Exception as error:  # reported by the test
            results[rank] = error

    threads = [threading.Thread(target=run, args=(rank,)) for rank in range(world.size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    return results



def test_threads_as_ranks_find_the_same_pairs():
    names = names_of(300)
    lower, upper = boxes_of(300, 3)

    def work(comm):
        own = slice(comm.rank, None, comm.size)
        cluster = winnow.Cluster(comm)
        assert cluster.hosted == (comm.rank, comm.rank + 1)
        cluster.add(names[own], lower[own], upper[own])
        found = []
        for step in range(3):
            found.append({tuple(pair) for pair in cluster.self_pairs().tolist()})
            here, low, high = cluster.bodies()
            cluster.move(here, low + np.float32(0.5), high + np.float32(0.5))
        return found, cluster.digest(), cluster.statistics

    results = run_on_threads(Threads(3), work)
    for result in results:
        assert not isinstance(result, Exception), result
    for step in range(3):
        by_rank = [result[0][step] for result in results]
        together = set().union(*by_rank)
        assert sum(map(len, by_rank)) == len(together)
        if step == 0:
            assert together == true_pairs(names, lower, upper)
    assert len({result[1] for result in results}) == 1
    assert results[0][2] == results[1][2] == results[2][2]
    assert results[0][2]["cuts"] > 0


def test_exception_of_a_communicator_ends_the_cluster():
    lower, upper = boxes_of(20, 4)

    def work(comm):
        cluster = winnow.Cluster(comm)
        cluster.add(np.arange(comm.rank, 20, comm.size), lower[comm.rank :: comm.size],
                    upper[comm.rank :: comm.size])
        try:
            for _ in range(20):
                cluster.self_pairs()
        except (ConnectionError, threading.BrokenBarrierError):
            refused("communication_failed", cluster.self_pairs)
            return "ended"
        return "went on"

    assert run_on_threads(Threads(2, breaks_at=7), work) == ["ended", "ended"]


def test_mpi_processes_find_the_same_pairs():
    if importlib.util.find_spec("mpi4py") is None or shutil.which("mpirun") is None:
        pytest.skip("there is no mpi4py")
    program = """
        import numpy, winnow
        from mpi4py import MPI
        comm = MPI.COMM_WORLD
        random = numpy.random.default_rng(5)
        lower = random.uniform(0, 8, (500, 3)).astype("f4")
        own = slice(comm.rank, None, comm.size)
        cluster = winnow.Cluster(comm)
        cluster.add(numpy.arange(500)[own], lower[own], lower[own] + 1)
        for _ in range(3):
            cluster.self_pairs()
        digest, pairs = cluster.digest(), cluster.statistics["pairs"]
        if comm.rank == 0:
            print(digest, pairs)
    """
    outputs = set()
    for ranks in (1, 3):
        command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), sys.executable,
                   "-c", textwrap.dedent(program)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=900)
        assert done.returncode == 0, done.stderr
        outputs.add(done.stdout.strip())
    assert len(outputs) == 1 and int(outputs.pop().split()[1]) > 100
