import pytest

import lumbrical as lum
from touching import ball_scene


@pytest.fixture
def session():
    return lum.Session(lum.Model(ball_scene()))
