"""The chunks of a study on a cluster of Ray whose machines see the folder: python sweep_ray.py STUDY"""

import sys

import ray

import flank


# a task whose worker dies begins again: the program finds the case that kills and makes it a row
@ray.remote(num_cpus=1, max_retries=40)
def computed(folder: str, chunk: int) -> None:
    flank.Study(folder).run((chunk, chunk), threads=1)


if __name__ == "__main__":
    study = flank.Study(sys.argv[1])
    ray.init()
    ray.get([computed.remote(study.folder, chunk) for chunk in range(study.progress()["chunks"])])
    print(study)
