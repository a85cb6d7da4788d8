"""The chunks of a study on the workers of a HyperQueue server: python sweep_hyperqueue.py STUDY SERVER_FOLDER"""

import sys
from pathlib import Path

from hyperqueue import Client, Job

import flank

if __name__ == "__main__":
    study = flank.Study(sys.argv[1])
    job = Job()
    for chunk in range(study.progress()["chunks"]):
        job.program(["flank", "sweep", "run", study.folder, "--chunks", f"{chunk}..{chunk}", "--threads", "1"])
    client = Client(Path(sys.argv[2]))
    client.wait_for_jobs([client.submit(job)])
    print(study)
